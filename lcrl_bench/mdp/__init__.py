"""Batched tabular MDPs, solved exactly: Q-iteration, occupancy, success. Nothing about houses."""
