"""DQN for many tasks in parallel: one network per task, model-free."""
