//! Visibility maps against big integers, rays, and each other.

mod drawing;
mod oracle;
mod real;
mod sensitivity;
mod shadow;
mod small;
