//! Visibility maps against big integers, rays, and each other.

mod oracle;
mod real;
mod sensitivity;
mod shadow;
mod small;
