//! Measured buildings and levels, where they are at hand.
