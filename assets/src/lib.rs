//! RayCast demo assets (being made).
