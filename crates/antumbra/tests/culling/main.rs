//! Culling against rays that know nothing of it, and what may never happen in a frame.

mod coherence;
mod odd;
mod rays;
