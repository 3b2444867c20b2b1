//! Parallel graph colourings with certificates. Part of Vivace, useful alone.
