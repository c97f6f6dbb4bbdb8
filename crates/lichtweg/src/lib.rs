//! Light transport.
