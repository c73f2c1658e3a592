"""Compiled layers for a CPU: module `x` here computes what `networks.x` computes in torch.

`docs/kernels.md` says how to read, change and test them.
"""
