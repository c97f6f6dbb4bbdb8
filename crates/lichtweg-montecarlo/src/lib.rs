//! Random numbers, sequences, distributions, running moments and statistical tests.
