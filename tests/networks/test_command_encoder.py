"""Words to numbers, and an LSTM that stops where a command stops."""

from __future__ import annotations

import torch

from lcrl_bench.networks.command_encoder import CommandEncoder
from lcrl_bench.networks.vocabulary import UNKNOWN, Vocabulary, tokenise

VOCABULARY = Vocabulary.of(["bed", "cup", "go", "move", "the", "to", "the"])


def make() -> CommandEncoder:
    return CommandEncoder(len(VOCABULARY), generator=torch.Generator().manual_seed(0))


def encode(*commands: str) -> torch.Tensor:
    with torch.no_grad():
        return make()(*VOCABULARY.encode(commands))


def test_case_and_punctuation_do_not_matter():
    assert tokenise("Go to the TV-stand!") == ["go", "to", "the", "tv", "stand"]
    assert torch.equal(encode("Go to the Bed."), encode("go to the bed"))


def test_words_are_numbered_in_order_and_unknown_ones_share_a_number():
    tokens, lengths = VOCABULARY.encode(["cup spoon fork", "bed"])
    assert tokens.tolist() == [[2, UNKNOWN, UNKNOWN], [1, UNKNOWN, UNKNOWN]]
    assert lengths.tolist() == [3, 1]
    assert len(VOCABULARY) == 7


def test_an_empty_command_is_a_command():
    _, lengths = VOCABULARY.encode(["", "go"])
    assert lengths.tolist() == [0, 1]
    assert encode("").tolist() == [[0.0] * 32]
    assert VOCABULARY.encode([])[0].shape == (0, 0)


def test_longer_neighbours_do_not_change_an_embedding():
    together = encode("go to the bed", "move the cup to the bed", "bed")
    for row, command in enumerate(["go to the bed", "move the cup to the bed", "bed"]):
        torch.testing.assert_close(together[row], encode(command)[0], rtol=0, atol=1e-6)


def test_the_order_of_words_matters():
    assert not torch.allclose(encode("move the cup to the bed"), encode("move the bed to the cup"))


def test_the_encoder_is_an_lstm_over_word_vectors():
    encoder = make()
    lstm = torch.nn.LSTM(32, 32, batch_first=True)
    state = {f"{name}_l0": value for name, value in encoder.cell.state_dict().items()}
    lstm.load_state_dict(state)
    tokens, lengths = VOCABULARY.encode(["move the cup to the bed"])
    expected, _ = lstm(encoder.words[tokens])
    torch.testing.assert_close(encoder(tokens, lengths), expected[:, -1])


def test_an_unknown_word_starts_neutral():
    assert float(make().words[UNKNOWN].detach().abs().max()) == 0.0
