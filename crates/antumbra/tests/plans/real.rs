//! Measured plans: offices and cities.
