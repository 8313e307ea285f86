//! RayCast's speed against its error: hard cases, other ways of casting, measurements, plots.

pub mod embree;
