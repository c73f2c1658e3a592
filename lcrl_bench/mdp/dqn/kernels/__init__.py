"""Compiled DQN for a CPU: module `x` here computes what `mdp.dqn.x` computes in torch.

`docs/kernels.md` says how to read, change and test them.
"""
