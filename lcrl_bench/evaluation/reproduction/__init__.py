"""The paper's tables from runs: experiments, the jobs behind them, the pages made of them."""
