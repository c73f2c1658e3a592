"""The network of the paper: panorama encoder, command LSTM, fusion. No training loops."""
