//! Visibility maps against big integers, rays, and each other.

mod oracle;
mod real;
mod shadow;
mod small;
