"""Names of scores are told in words, with their units."""

import pytest

from workbench.cli.scores import score_words


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("hip_rmse_rad", ("hip RMSE", "rad")),
        ("forward_m_s", ("forward", "m/s")),
        ("pitch_rate_peak_to_peak_rad_s", ("pitch rate peak to peak", "rad/s")),
        ("rear_right_force_n", ("rear right force", "N")),
        ("planted_share", ("planted share", "")),
    ],
)
def test_a_score_is_words_and_a_unit(name: str, words: tuple[str, str]) -> None:
    assert score_words(name) == words
