# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Reads the .vtu files that palpate writes (appended, raw, zlib) with numpy alone."""
import re
import zlib

import numpy

TYPES = {"Float64": "<f8", "Float32": "<f4", "Int64": "<i8", "Int32": "<i4", "UInt8": "u1"}


def read_arrays(path):
    """All numeric arrays of a file by name, those of several components as rows."""
    data = path.read_bytes()
    head, appended = data.split(b'<AppendedData encoding="raw">', 1)
    appended = appended[appended.index(b"_") + 1:]
    text = head.decode()
    size_type = {"UInt32": "<u4", "UInt64": "<u8"}[re.search(r'header_type="(\w+)"', text)[1]]
    arrays = {}
    for tag in re.findall(r"<DataArray [^>]*>", text):
        attributes = dict(re.findall(r'(\w+)="([^"]*)"', tag))
        if attributes["type"] not in TYPES:
            continue
        values = numpy.frombuffer(inflated(appended, int(attributes["offset"]), size_type),
                                  TYPES[attributes["type"]])
        components = int(attributes.get("NumberOfComponents", 1))
        arrays[attributes["Name"]] = values.reshape(-1, components) if components > 1 else values
    return arrays


def inflated(appended, offset, size_type):
    """The bytes of one array: number of blocks, sizes, then the compressed blocks."""
    width = numpy.dtype(size_type).itemsize
    num_blocks = int(numpy.frombuffer(appended, size_type, 1, offset)[0])
    sizes = numpy.frombuffer(appended, size_type, num_blocks, offset + 3 * width)
    at, out = offset + (3 + num_blocks) * width, b""
    for size in sizes.astype(int):
        out += zlib.decompress(appended[at:at + size])
        at += size
    return out
