"""What `lcrl-bench new-method` writes: a method called `my_method`, complete as it stands."""
