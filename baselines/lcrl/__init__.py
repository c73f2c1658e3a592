"""LC-RL: language-conditioned reward learning by maximum causal entropy IRL."""
