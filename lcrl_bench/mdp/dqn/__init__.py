"""DQN for many tasks at once: one network a task, dynamics met only by stepping."""
