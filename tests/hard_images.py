# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Label volumes that are damaged, misleading or odd, made from scratch: nothing is committed.

`refused()` gives the cases that must be refused, `accepted()` odd ones that are right. A case has a
name, the files by name (the first is the one to read) and, if it is refused, the exit code and a
word that the one sentence about it must hold.
"""
import gzip
import itertools
import struct
import typing
import zlib

SIDE = 12
UNREADABLE, UNUSABLE = 3, 4


class Case(typing.NamedTuple):
    name: str
    files: dict
    code: int = 0
    word: str = ""


def labels(side=SIDE):
    """A block of label 1 in a cube of label 0, one byte each."""
    inside = range(side // 4, side - side // 4)
    return bytes(1 if i in inside and j in inside and k in inside else 0
                 for k, j, i in itertools.product(range(side), repeat=3))


def nifti(voxels=None, order="<", offset=352, behind=b"", **fields):
    """A NIfTI-1 file; `fields` replace the header's."""
    h = dict(sizeof_hdr=348, dim=(3, SIDE, SIDE, SIDE, 1, 1, 1, 1), intent=0, datatype=2, bitpix=8,
             pixdim=(1, 1, 1, 1, 0, 0, 0, 0), vox_offset=float(offset), slope=0.0, inter=0.0, units=2,
             descrip=b"", aux_file=b"", db_name=b"", intent_name=b"", qform=0, sform=1,
             quatern=(0, 0, 0), qoffset=(0, 0, 0), srow=(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0),
             magic=b"n+1\0", extension=b"\0\0\0\0")
    unknown = set(fields) - set(h)
    assert not unknown, unknown
    h.update(fields)
    data = struct.pack(order + "i10s18sihcb", h["sizeof_hdr"], b"", h["db_name"], 0, 0, b"r", 0)
    data += struct.pack(order + "8h3fhhhh", *h["dim"], 0, 0, 0, h["intent"], h["datatype"],
                        h["bitpix"], 0)
    data += struct.pack(order + "8f3fhbb4f2i", *h["pixdim"], h["vox_offset"], h["slope"], h["inter"],
                        0, 0, h["units"], 0, 0, 0, 0, 0, 0)
    data += struct.pack(order + "80s24s2h6f12f16s4s", h["descrip"], h["aux_file"], h["qform"],
                        h["sform"], *h["quatern"], *h["qoffset"], *h["srow"], h["intent_name"],
                        h["magic"])
    assert len(data) == 348
    data += h["extension"]
    return data.ljust(offset, b"\0") + (labels() if voxels is None else voxels) + behind


def nrrd(voxels=None, fields=(), drop=(), encoding="raw", magic="NRRD0004"):
    """An NRRD file; `fields` replace or add lines."""
    h = {"type": "uint8", "dimension": "3", "space": "left-posterior-superior",
         "sizes": f"{SIDE} {SIDE} {SIDE}", "space directions": "(1,0,0) (0,1,0) (0,0,1)",
         "kinds": "domain domain domain", "encoding": encoding, "space origin": "(0,0,0)"}
    h.update(dict(fields))
    text = magic + "\n" + "".join(f"{k}: {v}\n" for k, v in h.items() if k not in drop)
    return (text + "\n").encode() + (labels() if voxels is None else voxels)


def meta(voxels=None, fields=(), drop=()):
    """A MetaImage file; `fields` replace or add lines."""
    h = {"ObjectType": "Image", "NDims": "3", "BinaryData": "True", "CompressedData": "False",
         "TransformMatrix": "1 0 0 0 1 0 0 0 1", "Offset": "0 0 0", "ElementSpacing": "1 1 1",
         "DimSize": f"{SIDE} {SIDE} {SIDE}", "ElementType": "MET_UCHAR"}
    data_file = dict(fields).get("ElementDataFile", "LOCAL")
    h.update({k: v for k, v in dict(fields).items() if k != "ElementDataFile"})
    text = "".join(f"{k} = {v}\n" for k, v in h.items() if k not in drop)
    return (text + f"ElementDataFile = {data_file}\n").encode() + (labels() if voxels is None else voxels)


def flipped(data, position):
    return data[:position] + bytes([data[position] ^ 0x10]) + data[position + 1:]


def floats(values, code="f"):
    return struct.pack(f"<{len(values)}{code}", *values)


def with_voxel(value, code):
    values = list(labels())
    values[100] = value
    return floats(values, code)


def _nifti_refused():
    plain, nan, inf = nifti(), float("nan"), float("inf")
    packed = gzip.compress(plain, mtime=0)
    one = dict(qform=1, sform=0)
    float_voxels = dict(datatype=16, bitpix=32)
    for name, data, code, word in [
        ("gzip cut in half", packed[:len(packed) // 2], 3, "cut off"),
        ("gzip without its trailer", packed[:-8], 3, "cut off"),
        ("gzip with a wrong checksum", flipped(packed, len(packed) - 7), 3, "damaged"),
        ("gzip with a wrong length", flipped(packed, len(packed) - 2), 3, "damaged"),
        ("gzip with a flipped bit", flipped(packed, len(packed) // 2), 3, "damaged"),
        ("gzip followed by text", packed + b"hello", 3, "followed"),
        ("gzip of half a file", gzip.compress(plain[:len(plain) // 2]), 3, "cut off"),
    ]:
        yield Case(f"nifti {name}", {"a.nii.gz": data}, code, word)
    for name, data, code, word in [
        ("cut in half", plain[:len(plain) // 2], 3, "cut off"),
        ("header only", plain[:352], 3, "cut off"),
        ("half a header", plain[:200], 3, "shorter"),
        ("empty", b"", 3, "empty"),
        ("text", b"not an image\n" * 100, 3, "not a NIfTI"),
        ("of version 2", struct.pack("<i", 540) + b"n+2\0\r\n\x1a\n" + bytes(2000), 3, "NIfTI-2"),
        ("header of a pair", nifti(magic=b"ni1\0"), 3, ".img"),
        ("with NaN in its sform", nifti(srow=(nan,) + (0,) * 11), 3, "sform"),
        ("with infinity in its sform", nifti(srow=(1, 0, 0, inf, 0, 1, 0, 0, 0, 0, 1, 0)), 3, "sform"),
        ("with NaN as voxel size", nifti(pixdim=(1, nan, 1, 1, 0, 0, 0, 0)), 3, "voxel size"),
        ("with NaN in its quaternion", nifti(quatern=(nan, 0, 0), **one), 3, "orientation"),
        ("with a quaternion that is too long", nifti(quatern=(1, 1, 0), **one), 3, "orientation"),
        ("with NaN as position", nifti(qoffset=(nan, 0, 0), **one), 3, "position"),
        ("in metres", nifti(units=1), 4, "metres"),
        ("in micrometres", nifti(units=3), 4, "micrometres"),
        ("of four dimensions", nifti(labels() * 2, dim=(4, SIDE, SIDE, SIDE, 2, 1, 1, 1)), 4, "dimensions"),
        ("of two dimensions", nifti(dim=(2, SIDE, SIDE, 1, 1, 1, 1, 1)), 4, "dimensions"),
        ("of a single slice", nifti(dim=(3, SIDE, SIDE, 1, 1, 1, 1, 1)), 4, "slice"),
        ("of vectors", nifti(intent=1007), 4, "vectors"),
        ("of displacements (1006)", nifti(intent=1006), 4, "vectors"),
        ("with a sheared sform", nifti(srow=(1, 0.5, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0)), 4, "right angles"),
        ("without any code", nifti(sform=0), 4, "where its voxels lie"),
        ("with a zero sform", nifti(srow=(0,) * 12), 4, "grid makes no sense"),
        ("with zero voxel size", nifti(pixdim=(1, 0, 1, 1, 0, 0, 0, 0), **one), 4, "grid makes no sense"),
        ("a million km away", nifti(srow=(1, 0, 0, 1e12, 0, 1, 0, 0, 0, 0, 1, 0)), 4, "grid makes no sense"),
        ("with an extent of zero", nifti(dim=(3, SIDE, 0, SIDE, 1, 1, 1, 1)), 3, "extent"),
        ("with a negative extent", nifti(dim=(3, SIDE, -5, SIDE, 1, 1, 1, 1)), 3, "extent"),
        ("with nine dimensions", nifti(dim=(9, SIDE, SIDE, SIDE, 1, 1, 1, 1)), 3, "dimensions"),
        ("with an overflow of extents", nifti(dim=(3, 32767, 32767, 32767, 1, 1, 1, 1)), 4, "2^30"),
        ("that claims more than it holds", nifti(dim=(3, 200, 200, 200, 1, 1, 1, 1)), 3, "cut off"),
        ("with bits that do not fit its type", nifti(bitpix=16), 3, "bits per voxel"),
        ("of colours", nifti(labels() * 3, datatype=128, bitpix=24), 4, "type 128"),
        ("of complex numbers", nifti(labels() * 8, datatype=32, bitpix=64), 4, "type 32"),
        ("with voxels inside the header", nifti(vox_offset=0.0), 3, "data offset"),
        ("with a NaN offset", nifti(vox_offset=nan), 3, "data offset"),
        ("with an offset beyond its end", nifti(vox_offset=1e8), 3, "cut off"),
        ("with a NaN scale", nifti(slope=nan), 3, "scale"),
        ("with a scale that makes fractions", nifti(slope=0.37), 4, "whole numbers"),
        ("with a NaN voxel", nifti(with_voxel(nan, "f"), **float_voxels), 4, "finite"),
        ("with an infinite voxel", nifti(with_voxel(inf, "f"), **float_voxels), 4, "finite"),
        ("with a fractional label", nifti(with_voxel(1.4, "f"), **float_voxels), 4, "whole numbers"),
        ("with a negative label", nifti(with_voxel(-3, "h"), datatype=4, bitpix=16), 4, "whole numbers"),
        ("with a label beyond 65535", nifti(with_voxel(70000, "i"), datatype=8, bitpix=32), 4, "whole numbers"),
        ("with megabytes behind its voxels", nifti(behind=bytes(3 << 20)), 3, "more data"),
    ]:
        yield Case(f"nifti {name}", {"a.nii": data}, code, word)


def _nrrd_refused():
    packed = gzip.compress(labels(), mtime=0)
    for name, data, code, word in [
        ("text", b"not an image\n" * 20, 3, "not an NRRD"),
        ("without sizes", nrrd(drop=["sizes"]), 3, "sizes"),
        ("without type", nrrd(drop=["type"]), 3, "type"),
        ("without encoding", nrrd(drop=["encoding"]), 3, "encoding"),
        ("with a field twice", nrrd(fields=[("type:  uint8\ntype", "uint16")]), 3, "twice"),
        ("of four dimensions", nrrd(labels() * 2, [("dimension", 4), ("sizes", "12 12 12 2")]), 4, "dimensions"),
        ("that contradicts itself", nrrd(fields=[("dimension", 4)]), 3, "contradicts"),
        ("with an extent of zero", nrrd(fields=[("sizes", "12 0 12")]), 3, "extent"),
        ("with a negative extent", nrrd(fields=[("sizes", "12 -12 12")]), 3, "extent"),
        ("with an overflow of extents", nrrd(fields=[("sizes", "4294967296 4294967296 4")]), 4, "2^30"),
        ("with a number too large", nrrd(fields=[("sizes", "99999999999999999999 2 2")]), 3, "bad number"),
        ("with words as extents", nrrd(fields=[("sizes", "twelve 12 12")]), 3, "bad number"),
        ("of blocks", nrrd(fields=[("type", "block")]), 4, "block"),
        ("in an odd encoding", nrrd(encoding="bzip2"), 3, "encoding"),
        ("as text", nrrd(encoding="ascii"), 3, "encoding"),
        ("with cut gzip", nrrd(packed[:20], encoding="gzip"), 3, "cut off"),
        ("with a wrong checksum", nrrd(flipped(packed, len(packed) - 6), encoding="gzip"), 3, "damaged"),
        ("cut in half", nrrd(labels()[:500]), 3, "cut off"),
        ("with a negative byte skip", nrrd(fields=[("byte skip", -1)]), 3, "byte skip"),
        ("with a line skip", nrrd(fields=[("line skip", 2)]), 3, "line skip"),
        ("in inches", nrrd(fields=[("space units", '"in" "in" "in"')]), 4, "lengths"),
        ("of vectors", nrrd(fields=[("kinds", "vector domain domain")]), 4, "vector"),
        ("with NaN as direction", nrrd(fields=[("space directions", "(nan,0,0) (0,1,0) (0,0,1)")]), 3, "bad number"),
        ("with too few directions", nrrd(fields=[("space directions", "(1,0,0) (0,1,0)")]), 3, "space directions"),
        ("with a sheared grid", nrrd(fields=[("space directions", "(1,0,0) (0.5,1,0) (0,0,1)")]), 4, "right angles"),
        ("with a flat grid", nrrd(fields=[("space directions", "(1,0,0) (0,0,0) (0,0,1)")]), 4, "grid makes no sense"),
        ("with an origin of infinity", nrrd(fields=[("space origin", "(inf,0,0)")]), 3, "bad number"),
        ("with data elsewhere", nrrd(fields=[("data file", "/etc/passwd")]), 3, "outside its folder"),
        ("with data above", nrrd(fields=[("data file", "../secret.raw")]), 3, "outside its folder"),
        ("with data in many files", nrrd(fields=[("data file", "slice%03d.raw 1 12 1")]), 3, "several files"),
        ("with data that are absent", nrrd(fields=[("data file", "gone.raw")]), 3, "no such file"),
        ("with a fractional label", nrrd(with_voxel(0.5, "f"), [("type", "float"), ("endian", "little")]), 4, "whole numbers"),
        ("with a NaN voxel", nrrd(with_voxel(float("nan"), "f"), [("type", "float"), ("endian", "little")]), 4, "whole numbers"),
    ]:
        yield Case(f"nrrd {name}", {"a.nrrd": data}, code, word)
    yield Case("nrrd with a NUL in a name", {"a.nhdr": nrrd(b"", [("data file", "a\0b.raw")])}, 3, "")


def _meta_refused():
    packed = zlib.compress(labels())
    gz = [("CompressedData", "True")]
    for name, data, code, word in [
        ("text", b"not an image\n" * 20, 3, "not a MetaImage"),
        ("without end of header", b"NDims = 3\n", 3, "no end"),
        ("with a field twice", meta(fields=[("NDims ", 3)]), 3, "twice"),
        ("without extents", meta(drop=["DimSize"]), 3, "contradicts"),
        ("of four dimensions", meta(labels() * 2, [("NDims", 4), ("DimSize", "12 12 12 2")]), 4, "dimensions"),
        ("that contradicts itself", meta(fields=[("NDims", 4)]), 3, "contradicts"),
        ("with an extent of zero", meta(fields=[("DimSize", "12 12 0")]), 3, "extent"),
        ("with a negative extent", meta(fields=[("DimSize", "-12 12 12")]), 3, "extent"),
        ("with an overflow of extents", meta(fields=[("DimSize", "4294967295 4294967295 4294967295")]), 4, "2^30"),
        ("with negative spacing", meta(fields=[("ElementSpacing", "1 -1 1")]), 4, "grid makes no sense"),
        ("with zero spacing", meta(fields=[("ElementSpacing", "1 0 1")]), 4, "grid makes no sense"),
        ("with NaN as spacing", meta(fields=[("ElementSpacing", "1 nan 1")]), 3, "bad number"),
        ("with a sheared matrix", meta(fields=[("TransformMatrix", "1 0.5 0 0 1 0 0 0 1")]), 4, "right angles"),
        ("with half a matrix", meta(fields=[("TransformMatrix", "1 0 0 0 1 0")]), 3, "TransformMatrix"),
        ("with three channels", meta(labels() * 3, [("ElementNumberOfChannels", 3)]), 4, "several numbers"),
        ("of an unknown type", meta(fields=[("ElementType", "MET_STRING")]), 4, "MET_STRING"),
        ("that is a tube", meta(fields=[("ObjectType", "Tube")]), 4, "not an image"),
        ("as text", meta(fields=[("BinaryData", "False")]), 3, "text"),
        ("in inches", meta(fields=[("DistanceUnits", "in")]), 4, "lengths"),
        ("with a header size", meta(fields=[("HeaderSize", -1)]), 3, "HeaderSize"),
        ("cut in half", meta(labels()[:700]), 3, "cut off"),
        ("with cut zlib", meta(packed[:15], gz), 3, "cut off"),
        ("with damaged zlib", meta(flipped(packed, len(packed) - 2), gz), 3, "damaged"),
        ("with data elsewhere", meta(b"", [("ElementDataFile", "/etc/passwd")]), 3, "another file"),
        ("with a fractional label", meta(with_voxel(2.5, "f"), [("ElementType", "MET_FLOAT")]), 4, "whole numbers"),
    ]:
        yield Case(f"meta {name}", {"a.mha": data}, code, word)
    for name, target in [("elsewhere", "/etc/passwd"), ("above", "../../etc/passwd"), ("hidden", "sub/../../x.raw")]:
        yield Case(f"meta with data {name}", {"a.mhd": meta(b"", [("ElementDataFile", target)])}, 3, "outside its folder")
    yield Case("meta with data in a list", {"a.mhd": meta(b"", [("ElementDataFile", "LIST")])}, 3, "several files")


def refused():
    yield from _nifti_refused()
    yield from _nrrd_refused()
    yield from _meta_refused()
    yield Case("an unknown format", {"a.dcm": bytes(1000)}, 3, "format is unknown")


def accepted():
    swapped = struct.pack(f">{SIDE ** 3}h", *labels())
    other = bytes(7 if v else 0 for v in labels())  # would be seen if the wrong file were read
    packed = gzip.compress(nifti(), mtime=0)
    # A comment that looks like a DICOM dump: ecode 4, 32 bytes.
    extension = b"\1\0\0\0" + struct.pack("<ii", 32, 4) + b"x" * 24
    for name, files in [
        ("plain", {"a.nii": nifti()}),
        ("compressed", {"a.nii.gz": packed}),
        ("compressed, of two members", {"a.nii.gz": gzip.compress(nifti()[:500]) + gzip.compress(nifti()[500:])}),
        ("compressed with padding", {"a.nii.gz": packed + bytes(512)}),
        ("big-endian", {"a.nii": nifti(swapped, order=">", datatype=4, bitpix=16)}),
        ("beside another of its name", {"a.nii.gz": packed, "a.nii": nifti(other)}),
        ("with an extension", {"a.nii": nifti(offset=384, extension=extension)}),
        ("of floating point", {"a.nii": nifti(floats(labels()), datatype=16, bitpix=32)}),
        ("scaled by one", {"a.nii": nifti(slope=1.0)}),
        ("without a unit", {"a.nii": nifti(units=0)}),
        ("with a fourth extent of one", {"a.nii": nifti(dim=(4, SIDE, SIDE, SIDE, 1, 1, 1, 1))}),
        ("left-handed", {"a.nii": nifti(srow=(-1, 0, 0, 5, 0, 1, 0, 0, 0, 0, 1, 0))}),
        ("oblique", {"a.nii": nifti(srow=(0.8, -0.6, 0, 0, 0.6, 0.8, 0, 0, 0, 0, 1, 0))}),
        ("with other sform and qform", {"a.nii": nifti(qform=1, sform=1, qoffset=(50, 0, 0))}),
        ("named in capitals", {"A.NII": nifti()}),
    ]:
        yield Case(f"nifti {name}", files)
    for name, files in [
        ("plain", {"a.nrrd": nrrd()}),
        ("compressed", {"a.nrrd": nrrd(gzip.compress(labels()), encoding="gzip")}),
        ("big-endian", {"a.nrrd": nrrd(swapped, [("type", "short"), ("endian", "big")])}),
        ("with comments and keys", {"a.nrrd": nrrd(fields=[("# who", "me"), ("key:=value\ncontent", "organs")])}),
        ("in RAS", {"a.nrrd": nrrd(fields=[("space", "right-anterior-superior")])}),
        ("with data beside it", {"a.nhdr": nrrd(b"", [("data file", "a.raw")]), "a.raw": labels()}),
    ]:
        yield Case(f"nrrd {name}", files)
    for name, files in [
        ("plain", {"a.mha": meta()}),
        ("compressed", {"a.mha": meta(zlib.compress(labels()), [("CompressedData", "True")])}),
        ("big-endian", {"a.mha": meta(swapped, [("ElementType", "MET_SHORT"), ("BinaryDataByteOrderMSB", "True")])}),
        ("with data beside it", {"a.mhd": meta(b"", [("ElementDataFile", "a.raw")]), "a.raw": labels()}),
    ]:
        yield Case(f"meta {name}", files)


def write(case, folder):
    """Writes the files; the path of the one to read."""
    for name, data in case.files.items():
        (folder / name).write_bytes(data)
    return folder / next(iter(case.files))
