"""The leaderboard's submissions and page."""
