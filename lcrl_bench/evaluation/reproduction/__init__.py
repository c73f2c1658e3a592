"""The paper's tables, reproduced: experiments, their runs, and the resulting pages."""
