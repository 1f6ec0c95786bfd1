# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""palpate aspirate contours on frames of another make, from files and from a pipe, and what is refused."""
import csv
import io
import json
import shutil
import subprocess

import numpy
import pytest

from tests.conftest import PROGRAM, run_palpate
from tests.independent import silhouettes

NUM_FRAMES = 16
SETTINGS = """[instrument]
hole_diameter_mm = 10.0
rim_thickness_mm = 0.5
pixel_r_um = 62.9
pixel_z_um = 31.75
base_row_px = 150
axis_column_px = 89.5
[frames]
rate_hz = 25.0
"""


@pytest.fixture()
def settings(tmp_path):
    path = tmp_path / "aspiration.toml"
    path.write_text(SETTINGS)
    return path


def write_frames(folder, frames):
    folder.mkdir()
    for number, frame in enumerate(frames):
        header = f"P5\n{frame.shape[1]} {frame.shape[0]}\n255\n".encode()
        (folder / f"frame{number:04d}.pgm").write_bytes(header + frame.tobytes())
    return folder


def from_pipe(settings, frames, size="180x180"):
    return subprocess.run([str(PROGRAM), "aspirate", "contours", "-", "--raw", size, "--config", str(settings),
                           "--quiet"], input=b"".join(frame.tobytes() for frame in frames), capture_output=True,
                          timeout=300)


def judged(text, truths):
    """Errors in pixels of points without a flag, and the share of those with one."""
    errors, flagged, points = [], 0, 0
    for row in csv.DictReader(io.StringIO(text)):
        frame = round(float(row["time_s"]) * 25)
        column = round(float(row["r_mm"]) / 0.0629 + 89.5)
        true = truths[frame][column]
        if true > silhouettes.VISIBLE_ROWS - 6:
            continue
        points += 1
        if row["flag"] != "0":
            flagged += 1
        else:
            errors.append(150 - float(row["z_mm"]) / 0.03175 - true)
    return numpy.array(errors), flagged / points


@pytest.mark.parametrize("kind", silhouettes.SUITE, ids=lambda kind: kind.name)
def test_points_that_are_wrong_are_flagged(kind, settings):
    errors, flagged = [], []
    for seed in (1, 2):
        frames, truths = zip(*silhouettes.film(kind, seed, NUM_FRAMES))
        finished = from_pipe(settings, frames)
        assert finished.returncode == 0, finished.stderr
        some, share = judged("\n".join(line for line in finished.stdout.decode().splitlines() if line[0] != "#"),
                             truths)
        errors.append(some)
        flagged.append(share)
    errors = numpy.concatenate(errors)
    near = errors[numpy.abs(errors) <= 3]
    wrong = 1 - len(near) / len(errors)
    print(f"{kind.name}: rms {near.std():.3f} px, bias {near.mean():.3f}, beyond 3 px {100 * wrong:.2f} %, "
          f"flagged {100 * numpy.mean(flagged):.1f} %")
    assert wrong <= 0.01
    assert numpy.mean(flagged) <= 0.15


def test_files_and_a_pipe_give_the_same_bytes(settings, tmp_path):
    frames = [frame for frame, _ in silhouettes.film(silhouettes.SUITE[0], 3, 12)]
    folder = write_frames(tmp_path / "frames", frames)

    finished = run_palpate("aspirate", "contours", folder, "--config", settings, "--out", tmp_path / "out", "--quiet")
    piped = from_pipe(settings, frames)

    assert finished.returncode == 0, finished.stderr
    lines = [line for line in piped.stdout.splitlines(keepends=True) if not line.startswith(b"#")]
    assert (tmp_path / "out/profiles.csv").read_bytes() == b"".join(lines)
    result = json.loads((tmp_path / "out/result.json").read_text())
    assert result["frames"] == 12
    assert result["travel_mm"] == pytest.approx(1.6, abs=0.1)
    assert "data:image/png" in (tmp_path / "out/contours.html").read_text()


def encode(frames, target, *options):
    """Frames as a film, or a file each, by ffmpeg."""
    height, width = frames[0].shape
    subprocess.run(["ffmpeg", "-v", "error", "-f", "rawvideo", "-pix_fmt", "gray", "-video_size", f"{width}x{height}",
                    "-framerate", "25", "-i", "-", *options, str(target)],
                   input=b"".join(frame.tobytes() for frame in frames), check=True, timeout=100)
    return target


needs_ffmpeg = pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="films are made and read by ffmpeg")


@needs_ffmpeg
@pytest.mark.parametrize("ending, pixels", [("png", "gray"), ("png", "gray16be"), ("png", "rgb24"), ("tif", "gray"),
                                            ("tiff", "gray16le")])
def test_pictures_of_every_kind_give_the_same_bytes(ending, pixels, settings, tmp_path):
    frames = [frame for frame, _ in silhouettes.film(silhouettes.SUITE[0], 3, 12)]
    (tmp_path / "frames").mkdir()
    encode(frames, tmp_path / f"frames/%04d.{ending}", "-pix_fmt", pixels)
    finished = run_palpate("aspirate", "contours", tmp_path / "frames", "--config", settings, "--quiet")
    assert finished.returncode == 0, finished.stderr
    assert finished.stdout.encode() == from_pipe(settings, frames).stdout


@needs_ffmpeg
def test_a_film_gives_the_same_bytes_and_its_own_times(settings, tmp_path):
    frames = [frame for frame, _ in silhouettes.film(silhouettes.SUITE[0], 3, 12)]
    film = encode(frames, tmp_path / "film.mkv", "-c:v", "ffv1")
    settings.write_text(SETTINGS.split("[frames]")[0])
    finished = run_palpate("aspirate", "contours", film, "--config", settings, "--quiet")
    assert finished.returncode == 0, finished.stderr
    settings.write_text(SETTINGS)
    assert finished.stdout.encode() == from_pipe(settings, frames).stdout
    # what the settings say of times goes before what the film says
    settings.write_text(SETTINGS.replace("25.0", "50.0"))
    finished = run_palpate("aspirate", "contours", film, "--config", settings, "--quiet")
    assert finished.stdout.encode() == from_pipe(settings, frames).stdout
    # a film of a codec that loses a little
    lossy = encode(frames, tmp_path / "film.avi", "-c:v", "mjpeg", "-q:v", "2")
    finished = run_palpate("aspirate", "contours", lossy, "--config", settings, "--out", tmp_path / "out", "--quiet")
    assert finished.returncode == 0, finished.stderr
    assert json.loads((tmp_path / "out/result.json").read_text())["travel_mm"] == pytest.approx(1.6, abs=0.1)


@needs_ffmpeg
def test_damaged_films_and_pictures_get_their_code(settings, tmp_path):
    frames = [frame for frame, _ in silhouettes.film(silhouettes.SUITE[0], 3, 4)]
    whole = encode(frames, tmp_path / "film.mkv", "-c:v", "ffv1").read_bytes()
    (tmp_path / "cut.mkv").write_bytes(whole[:len(whole) // 2])
    damaged = bytearray(encode(frames, tmp_path / "film.mp4", "-c:v", "libx264", "-qp", "0").read_bytes())
    damaged[len(damaged) // 2:len(damaged) // 2 + 400] = bytes(400)
    (tmp_path / "damaged.mp4").write_bytes(damaged)
    (tmp_path / "none.avi").write_bytes(b"no film")
    (tmp_path / "sound.mp4").write_bytes(encode(frames, tmp_path / "short.mp4", "-frames:v", "1").read_bytes()[:300])
    pictures = tmp_path / "pictures"
    pictures.mkdir()
    encode(frames, pictures / "%04d.png")
    two_kinds = write_frames(tmp_path / "two", frames)
    (two_kinds / "a.png").write_bytes((pictures / "0001.png").read_bytes())
    (pictures / "0003.png").write_bytes((pictures / "0003.png").read_bytes()[:900])
    for path, words in [("cut.mkv", "cannot read the film"), ("damaged.mp4", "frame"), ("none.avi", "frame 1"),
                        ("sound.mp4", "cannot read the film"), ("missing.mp4", "cannot read the film"),
                        ("pictures", "0003.png': it is damaged or cut"), ("two", "two kinds")]:
        finished = run_palpate("aspirate", "contours", tmp_path / path, "--config", settings, "--out", tmp_path / "out",
                               "--quiet")
        assert finished.returncode == 3, (path, finished.stderr)
        assert words in finished.stderr, path
        assert not (tmp_path / "out").exists()


def test_without_ffmpeg_a_sentence_says_so(settings, tmp_path):
    (tmp_path / "film.mp4").write_bytes(b"any")
    finished = run_palpate("aspirate", "contours", tmp_path / "film.mp4", "--config", settings, "--quiet",
                           environment={"PATH": str(tmp_path)})
    assert finished.returncode == 2
    assert "ffmpeg, which is not in PATH" in finished.stderr


def test_bad_input_gets_its_code_and_a_sentence(settings, tmp_path):
    good = [frame for frame, _ in silhouettes.film(silhouettes.SUITE[0], 4, 2)]
    smaller = [good[0], good[1][:170]]
    cut = write_frames(tmp_path / "cut", good)
    (cut / "frame0001.pgm").write_bytes((cut / "frame0001.pgm").read_bytes()[:500])
    (tmp_path / "empty").mkdir()
    cases = [
        (cut, 3, "is cut"),
        (write_frames(tmp_path / "sizes", smaller), 3, "one film"),
        (tmp_path / "empty", 3, "no folder with frames"),
        (tmp_path / "missing", 3, "no folder with frames"),
        (write_frames(tmp_path / "black", [0 * good[0]]), 4, "all black"),
        (write_frames(tmp_path / "white", [0 * good[0] + 255]), 4, "all white"),
        (write_frames(tmp_path / "grey", [0 * good[0] + 90] * 2), 4, "no tissue"),
    ]
    for folder, code, words in cases:
        finished = run_palpate("aspirate", "contours", folder, "--config", settings, "--out", tmp_path / "out")
        assert finished.returncode == code, (folder, finished.stderr)
        assert words in finished.stderr
        assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("change, words", [
    (("rate_hz = 25.0", "rate_hz = 25.0\nshutter = 1"), "shutter"),
    (("pixel_r_um = 62.9\n", ""), "pixel_r_um"),
    (("rate_hz = 25.0", "rate_hz = -1"), "rate_hz"),
    (("rate_hz = 25.0", 'rate_hz = 25.0\nmethod = "guess"'), "method"),
])
def test_settings_are_read_strictly(change, words, settings, tmp_path):
    settings.write_text(SETTINGS.replace(*change))
    frames = write_frames(tmp_path / "frames", [numpy.full((180, 180), 90, numpy.uint8)])
    finished = run_palpate("aspirate", "contours", frames, "--config", settings, "--out", tmp_path / "out")
    assert finished.returncode == 2
    assert words in finished.stderr


def test_tissue_that_is_darker_than_told_is_refused(settings, tmp_path):
    frames = [frame for frame, _ in silhouettes.film(silhouettes.SUITE[0], 4, 6)]
    for told, shown in (("darker", frames), ("brighter", [255 - frame for frame in frames])):
        settings.write_text(SETTINGS.replace("[frames]", f'tissue = "{told}"\n[frames]'))
        finished = run_palpate("aspirate", "contours", write_frames(tmp_path / told, shown), "--config", settings,
                               "--out", tmp_path / "out")
        assert finished.returncode == 4, finished.stdout
        other = {"darker": "brighter", "brighter": "darker"}[told]
        assert f'set tissue = "{other}"' in finished.stderr and not (tmp_path / "out").exists()


def test_the_axis_is_told_in_whole_frames(settings, tmp_path):
    settings.write_text(SETTINGS.replace("[frames]", "crop_px = [12, 0, 160, 180]\n[frames]"))
    frames = write_frames(tmp_path / "frames", [frame for frame, _ in silhouettes.film(silhouettes.SUITE[0], 5, 4)])
    finished = run_palpate("aspirate", "contours", frames, "--config", settings, "--out", tmp_path / "out")
    assert finished.returncode == 0, finished.stderr
    assert json.loads((tmp_path / "out/result.json").read_text())["axis_column_px"] == 89.5


def test_cropped_timed_and_calibrated_films_give_the_same_profiles(settings, tmp_path):
    frames = [frame for frame, _ in silhouettes.film(silhouettes.SUITE[0], 5, 6)]
    plain = from_pipe(settings, frames).stdout
    assert plain.count(b"\n") > 500
    (tmp_path / "times.csv").write_text("time_s\n" + "".join(f"{k / 25}\n" for k in range(6)))
    # rows of tips in the whole frame: 7 rows more are above
    (tmp_path / "tips.csv").write_text("length_mm,row_px\n" + "".join(f"{mm},{157 - mm / 0.03175:.6f}\n"
                                                                        for mm in (0, 1.5, 3)))
    settings.write_text(SETTINGS.replace("rate_hz = 25.0", 'times = "times.csv"')
                        .replace("pixel_z_um = 31.75\nbase_row_px = 150", 'calibration = "tips.csv"')
                        .replace("axis_column_px = 89.5", "axis_column_px = 94.5\ncrop_px = [5, 7, 180, 180]"))
    wider = [numpy.pad(frame, ((7, 3), (5, 2)), constant_values=255) for frame in frames]
    other = from_pipe(settings, wider, "187x190")
    assert other.returncode == 0, other.stderr
    rows = [numpy.array([[float(cell) for cell in line.split(",")] for line in text.decode().splitlines()[1:]
                         if line[0] != "#"]) for text in (plain, other.stdout)]
    numpy.testing.assert_allclose(rows[1], rows[0], atol=2e-4)

    (tmp_path / "times.csv").write_text("time_s\n0\n0.04\n")
    assert from_pipe(settings, wider, "187x190").returncode == 4  # more frames than times
    (tmp_path / "times.csv").write_text("time_s\n" + "".join(f"{k / 25}\n" for k in range(9)))
    finished = from_pipe(settings, wider, "187x190")
    assert finished.returncode == 4 and b"9 times for 6 frames" in finished.stderr
    settings.write_text(SETTINGS.replace("[frames]", "crop_px = [100, 0, 180, 180]\n[frames]"))
    finished = from_pipe(settings, frames)
    assert finished.returncode == 4 and b"crop_px" in finished.stderr
