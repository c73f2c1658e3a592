"""The leaderboard: submissions, their verification by running again, and its page."""
