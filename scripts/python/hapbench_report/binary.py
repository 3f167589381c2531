"""Numbers as text for a page: little endian, base64."""
import base64
import sys
from array import array


def base64_of(code, values):
    packed = array(code, values)
    if sys.byteorder == "big":
        packed.byteswap()
    return base64.b64encode(packed.tobytes()).decode()
