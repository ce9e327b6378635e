"""What QGroundControl asks, once each and within its own time-outs."""

import struct
import time
import zlib

from groundstation import MAV, GroundStation
from pymavlink.generator.mavcrc import x25crc

# s, as its sources have them.
ACKNOWLEDGED = 3.0
MESSAGE = 2.2
FTP = 1.0
HASH = 1.0
PARAMETERS = 5.0
MISSION = 1.5
LOG_LIST = 5.0
LOG_DATA = 0.5
COMPONENT_METADATA = 397
METADATA_EXTRA = 182
AVAILABLE_MODES = 435
PIECE = 90


def crc32(crc, data):
    """Without the inversions of zlib's."""
    return zlib.crc32(data, crc ^ 0xFFFFFFFF) ^ 0xFFFFFFFF


class Qgc(GroundStation):
    def __init__(self, port):
        # Of its messages only this dialect has all.
        super().__init__(port, dialect="all")
        self.system = 1 + self.system_offset
        self.ftp_sequence = 0

    def once(self, send, kind, limit, matches=lambda message: True):
        """One request, one answer in time."""
        begin = time.monotonic()
        with self.lock:
            send(self.link.mav)
        while (left := begin + limit - time.monotonic()) > 0:
            message = self.listen(kind, timeout=left)
            if message is not None and matches(message):
                return message
        raise AssertionError(f"no {kind} in {limit} s; texts: {self.texts}")

    def order(self, command, *params):
        """COMMAND_LONG; its result."""
        filled = list(params) + [0.0] * (7 - len(params))
        ack = self.once(
            lambda mav: mav.command_long_send(self.system, 1, command, 0, *filled),
            "COMMAND_ACK", ACKNOWLEDGED, lambda ack: ack.command == command,
        )
        return ack.result

    def order_at(self, command, params, latitude, longitude, altitude):
        """COMMAND_INT above the sea; its result."""
        ack = self.once(
            lambda mav: mav.command_int_send(
                self.system, 1, MAV.MAV_FRAME_GLOBAL, command, 0, 0, *params, latitude, longitude, altitude
            ),
            "COMMAND_ACK", ACKNOWLEDGED, lambda ack: ack.command == command,
        )
        return ack.result

    def message(self, number, kind, argument=0):
        """REQUEST_MESSAGE."""
        return self.once(
            lambda mav: mav.command_long_send(
                self.system, 1, MAV.MAV_CMD_REQUEST_MESSAGE, 0, number, argument, 0, 0, 0, 0, 0
            ),
            kind, MESSAGE,
        )

    def metadata(self):
        """COMPONENT_METADATA, which pymavlink does not know: checksum and place of the file that describes the rest."""
        frame = bytes(self.message(COMPONENT_METADATA, f"UNKNOWN_{COMPONENT_METADATA}").get_msgbuf())
        body, sum_of = frame[1:-2], x25crc(frame[1:-2])
        sum_of.accumulate(bytes([METADATA_EXTRA]))
        assert struct.pack("<H", sum_of.crc) == frame[-2:]
        _, crc, uri = struct.unpack("<II100s", body[9:].ljust(108, b"\0"))
        return crc, uri.rstrip(b"\0").decode()

    def file_operation(self, opcode, session=0, offset=0, size=0, data=b""):
        """One step of MAVLink FTP: session, size of the reply, its data."""
        self.ftp_sequence += 1
        head = struct.pack("<HBBBBBBI", self.ftp_sequence, session, opcode, size or len(data), 0, 0, 0, offset)
        payload = (head + data).ljust(251, b"\0")
        reply = self.once(
            lambda mav: mav.file_transfer_protocol_send(0, self.system, 1, payload),
            "FILE_TRANSFER_PROTOCOL", FTP, lambda reply: reply.payload[5] == opcode,
        )
        data = bytes(reply.payload)
        assert data[3] == 128, f"refused: {data[:16].hex()}"
        return data[2], data[12 : 12 + data[4]]

    def file(self, uri):
        """By plain reads, as it does again what a burst has lost."""
        name = uri.removeprefix("mftp://").encode()
        session, size = self.file_operation(4, data=name)
        [size] = struct.unpack("<I", size)
        found = b""
        while len(found) < size:
            found += self.file_operation(5, session, len(found), size=min(239, size - len(found)))[1]
        self.file_operation(1, session)
        return found

    def log(self, entry):
        """LOG_REQUEST_DATA, and again what of it was lost."""
        pieces = {}
        while (missing := [at for at in range(0, entry.size, PIECE) if at not in pieces]):
            with self.lock:
                self.link.mav.log_request_data_send(self.system, 1, entry.id, missing[0], entry.size - missing[0])
            heard = len(pieces)
            while (data := self.listen("LOG_DATA", timeout=LOG_DATA)) is not None and data.count:
                pieces[data.ofs] = bytes(data.data[: data.count])
                if len(pieces) * PIECE >= entry.size:
                    break
            assert len(pieces) > heard, "no LOG_DATA in time"
        with self.lock:
            self.link.mav.log_request_end_send(self.system, 1)
        return b"".join(pieces[at] for at in sorted(pieces))
