"""Everything people look at: Rerun recordings and plots."""
