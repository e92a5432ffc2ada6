"""Files made to do harm end in one line: nothing runs, nothing outside is read, memory stays bounded."""

from __future__ import annotations

import contextlib
import gzip
import io
import json
import os
import pickle
import struct
import zipfile
import zlib
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

from tests.proposing.test_formats import lerobot
from workbench.core import InputError
from workbench.proposing import open_table, propose

resource = pytest.importorskip("resource")


class Trap:
    """Unpickled, it would make a folder."""

    def __init__(self, marker: Path) -> None:
        self.marker = marker

    def __reduce__(self) -> tuple:
        return os.mkdir, (str(self.marker),)


def refused(path: Path, match: str) -> None:
    limits = resource.getrlimit(resource.RLIMIT_AS)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(InputError, match=match) as caught:
        open_table(path)
    assert "\n" not in str(caught.value) and caught.value.remedy
    assert resource.getrlimit(resource.RLIMIT_AS) == limits
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 1.5 * 2**20  # KiB


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "is empty"),
        ("\n\n", "is empty"),
        ("t,q_lift,q_bend\n", "one line only, and no rows below it"),
        ("a log\nof words\n", "no two columns of numbers"),
    ],
)
def test_a_text_without_a_table_is_told_by_what_it_lacks(text: str, says: str, tmp_path: Path) -> None:
    file = tmp_path / "log.csv"
    file.write_text(text)
    refused(file, says)


def test_a_name_that_stands_twice_in_a_header_is_told(tmp_path: Path) -> None:
    file = tmp_path / "log.csv"
    file.write_text("t,q_lift,q_lift\n" + "".join(f"{0.01 * k},{k % 7}.5,{k % 5}.5\n" for k in range(40)))
    table = open_table(file)
    assert list(table.columns) == ["t", "q_lift", "q_lift_3"]
    assert any("'q_lift' stands more than once" in n and "'q_lift_3'" in n for n in table.notes)


def test_pickles_are_not_opened(tmp_path: Path) -> None:
    marker = tmp_path / "ran"
    (tmp_path / "run.pkl").write_bytes(pickle.dumps(Trap(marker)))
    refused(tmp_path / "run.pkl", "run code")
    np.save(tmp_path / "run.npy", np.array([Trap(marker)], dtype=object), allow_pickle=True)
    refused(tmp_path / "run.npy", "run code")
    np.savez(tmp_path / "run.npz", t=np.arange(9.0), q=np.array([Trap(marker)], dtype=object))
    refused(tmp_path / "run.npz", "run code")
    assert not marker.exists()


def test_a_header_that_claims_everything(tmp_path: Path) -> None:
    out = io.BytesIO()
    np.lib.format.write_array_header_1_0(out, {"descr": "<f8", "fortran_order": False, "shape": (2**50,)})
    (tmp_path / "run.npy").write_bytes(out.getvalue() + b"\0" * 64)
    refused(tmp_path / "run.npy", "claims to hold")


def test_a_gzip_that_unpacks_for_ever(tmp_path: Path) -> None:
    part = gzip.compress(b"0,0\n" * 2**22)
    (tmp_path / "run.csv.gz").write_bytes(gzip.compress(b"t,q\n") + part * 40)
    refused(tmp_path / "run.csv.gz", "claims to hold")


def test_a_zip_that_claims_to_unpack_for_ever(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "run.npz", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("q.npy", b"\0" * 2**20)
        archive.getinfo("q.npy").file_size = 600 * 2**20
    refused(tmp_path / "run.npz", "claims to hold")


def test_a_matlab_file_that_unpacks_for_ever(tmp_path: Path) -> None:
    path = tmp_path / "run.mat"
    savemat(path, {"t": np.arange(20.0)})
    pack = zlib.compressobj(9, zlib.DEFLATED, -15)
    block = pack.compress(b"\0" * 2**20) + pack.flush(zlib.Z_FULL_FLUSH)  # may stand any number of times
    checksum = ((600 * 2**20 % 65521) << 16) | 1
    body = b"\x78\x9c" + 600 * block + pack.flush() + struct.pack(">I", checksum)
    path.write_bytes(path.read_bytes() + struct.pack("<II", 15, len(body)) + body)
    refused(path, "claims to hold|not a readable MATLAB")


def test_a_matlab_cell_that_claims_everything(tmp_path: Path) -> None:
    path = tmp_path / "run.mat"
    savemat(path, {"c": np.array([1, 2], dtype=object)})
    raw = path.read_bytes()
    at = raw.index(struct.pack("<IIii", 5, 8, 1, 2)) + 8
    path.write_bytes(raw[:at] + struct.pack("<ii", 2**15, 2**15) + raw[at + 8 :])
    refused(path, "claims to hold|not a readable MATLAB")


@pytest.mark.parametrize("name", ["run.zip", "run.tar.gz", "run.7z", "run.xlsx", "run.h5"])
def test_archives_and_others_are_named(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_bytes(b"PK\3\4 whatever")
    refused(tmp_path / name, "is an? ")


def test_random_bytes_under_every_ending(tmp_path: Path) -> None:
    noise = np.random.default_rng(0).bytes(4000)
    for ending in ("csv", "csv.gz", "txt", "parquet", "mat", "npy", "npz", "mcap", "blf", "asc", "log"):
        path = tmp_path / f"run.{ending}"
        path.write_bytes(noise)
        with pytest.raises(InputError):
            open_table(path)


def test_truncated_files_under_every_ending(tmp_path: Path) -> None:
    t = np.arange(50.0)
    savemat(tmp_path / "run.mat", {"t": t, "q": t}, do_compression=True)
    np.savez(tmp_path / "run.npz", t=t, q=t)
    for path in tmp_path.iterdir():
        path.write_bytes(path.read_bytes()[:-150])
        with pytest.raises(InputError):
            open_table(path)


def test_links_that_lead_out(tmp_path: Path) -> None:
    folder = lerobot(tmp_path / "set")
    data = folder / "data" / "chunk-000" / "episode_000000.parquet"
    data.rename(tmp_path / "outside.parquet")
    data.symlink_to(tmp_path / "outside.parquet")
    refused(folder, "outside its folder")
    info = folder / "meta" / "info.json"
    info.rename(tmp_path / "info.json")
    info.symlink_to(tmp_path / "info.json")
    refused(folder, "outside its folder")


def test_bags_whose_files_lie_elsewhere(tmp_path: Path) -> None:
    bag = tmp_path / "bag"
    bag.mkdir()
    (tmp_path / "secret.db3").write_bytes(b"")
    content = {
        "version": 5,
        "storage_identifier": "sqlite3",
        "duration": {"nanoseconds": 1},
        "starting_time": {"nanoseconds_since_epoch": 0},
        "message_count": 1,
        "topics_with_message_count": [],
        "relative_file_paths": ["../secret.db3"],
    }
    (bag / "metadata.yaml").write_text(json.dumps({"rosbag2_bagfile_information": content}))
    refused(bag, "not a readable bag")
    (bag / "secret.db3").symlink_to(tmp_path / "secret.db3")
    refused(bag, "outside its folder")
    (bag / "secret.db3").unlink()
    packed = {**content, "compression_mode": "FILE", "compression_format": "zstd"}
    (bag / "metadata.yaml").write_text(json.dumps({"rosbag2_bagfile_information": packed}))
    refused(bag, "not a readable bag|compressed")


def test_json_that_nests_without_end(tmp_path: Path) -> None:
    folder = lerobot(tmp_path / "set")
    (folder / "meta" / "info.json").write_text("[" * 100_000)
    refused(folder, "JSON")


@pytest.mark.parametrize("header", [b"{'descr': (", b"{'descr': 1}", b"[]", b"{[]: 1}"])
def test_a_numpy_header_that_is_no_header(header: bytes, tmp_path: Path) -> None:
    text = header.ljust(117) + b"\n"
    (tmp_path / "run.npy").write_bytes(
        b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text + bytes(800)
    )
    refused(tmp_path / "run.npy", "not a readable NumPy")


def test_a_clock_that_stands_still(tmp_path: Path, recwarn: pytest.WarningsRecorder) -> None:
    rows = "\n".join(f"0.5\t{0.1 * k}\t{0.2 * k}" for k in range(60))
    (tmp_path / "run.tsv").write_text(f"t\tq_hip\tq_knee\n{rows}\n")
    with contextlib.suppress(InputError):
        propose(open_table(tmp_path / "run.tsv"))
    assert not recwarn.list
