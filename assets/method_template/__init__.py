"""The template of `lcrl-bench new-method`: a method named `my_method`, which works as it is."""
