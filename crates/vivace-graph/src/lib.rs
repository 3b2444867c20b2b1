//! Constraint graphs in compressed rows, for colouring and Gauss-Seidel. Part of Vivace.
