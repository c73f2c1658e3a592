"""Programs that time other libraries, in an environment of their own.

They run outside the suite's environment, so they import nothing of it.
"""
