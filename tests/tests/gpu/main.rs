//! The GPU backend against the CPU's. These tests need an adapter, if a software one, and fail where there is none.

mod colorings;
