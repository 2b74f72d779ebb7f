# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Explains why the bytes that arrived contain no valid reply to a request over RS-485."""

from __future__ import annotations

from .link_errors import DisturbedError, LinkError, NoReplyError, WrongEncoderError
from .replies import PendingRequest, compute_xor, find_error
from .session_requests import SessionRequests, format_hex

#: Maximum number of received bytes that an error prints.
_PRINTED_BYTES = 24


class FailureExplainer:
    """Explains failed requests of one session.

    Attributes:
        suspicious_replies: Number of consecutive replies that seem to come from another kind of encoder.
    """

    def __init__(self, requests: SessionRequests) -> None:
        self.suspicious_replies = 0
        self._requests = requests

    def explain(self, received: bytes, pending: PendingRequest, timeout_s: float) -> LinkError:
        """Return the error for received bytes that contain no valid reply. Its class indicates the most likely cause.

        NoReplyError means that nothing has arrived except an echo or another reply. WrongEncoderError means that
        two consecutive replies seem to come from another kind of encoder. All other causes are a DisturbedError.
        """
        kind = pending.kind
        request_text = f"the request {format_hex(pending.data)} to {self._requests.encoder.code}"
        ellipsis = " ..." if len(received) > _PRINTED_BYTES else ""
        bytes_text = format_hex(received[:_PRINTED_BYTES]) + ellipsis
        if not received:
            milliseconds = f"{1000 * timeout_s:g} ms"
            text = f"no reply to {request_text} within {milliseconds}; check supply, wires A and B, and baud rate"
            return NoReplyError(text)
        if received == pending.data:
            text = f"only an echo of {request_text}; check the wires to the encoder, and its supply"
            return NoReplyError(text, received)
        if not any(received):
            text = f"the line is low after {request_text}: only 00 arrives; check whether A and B are swapped"
            return DisturbedError(text, received)
        if self._requests.exchanges:
            return self._exchange_error(received, pending, request_text, bytes_text)
        # Why the bytes seem to be from another kind of encoder. Empty if they do not.
        suspicion = self._explain_other_encoder(received, pending)
        # 1 in 256 corrupted replies has a valid CRC, so one odd reply proves nothing.
        self.suspicious_replies = self.suspicious_replies + 1 if suspicion else 0
        if self.suspicious_replies > 1:
            text = (
                f"the reply {bytes_text} to {request_text} is from another kind of encoder: {suspicion}; "
                "check the order code"
            )
            return WrongEncoderError(text, received)
        if received[0] in self._requests.kinds and received[0] != kind.control:
            return NoReplyError(
                f"no reply to {request_text}, but a late one to another request: {bytes_text}", received
            )
        if len(received) < kind.length:
            text = f"incomplete reply to {request_text}: {len(received)} of {kind.length} bytes, {bytes_text}"
            return DisturbedError(text, received)
        return DisturbedError(f"no valid reply to {request_text} in {bytes_text}", received)

    def _exchange_error(
        self, received: bytes, pending: PendingRequest, request_text: str, bytes_text: str
    ) -> LinkError:
        """Return the error for received bytes without a valid reply from an encoder whose requests have no data IDs.

        Its text says whether the reply is incomplete, differs from a value in the request, or is invalid.
        ``request_text`` names the request, and ``bytes_text`` contains the received bytes.
        """
        if len(received) < pending.kind.length:
            text = f"incomplete reply to {request_text}: {len(received)} of {pending.kind.length} bytes, {bytes_text}"
            return DisturbedError(text, received)
        last_bytes = received[-pending.kind.length :]
        is_valid_frame = find_error(last_bytes, pending) is None
        difference = self._requests.find_difference(pending, pending.decode(last_bytes)) if is_valid_frame else ""
        return DisturbedError(difference or f"no valid reply to {request_text} in {bytes_text}", received)

    def _explain_other_encoder(self, received: bytes, pending: PendingRequest) -> str:
        """Return why the bytes seem to come from another kind of encoder, or an empty string if they do not.

        Such bytes begin like a reply and have a valid CRC, but another length or values that this encoder does not
        send.
        """
        begins_like_reply = received[0] == pending.kind.control and len(received) >= 3
        # The CRC is the XOR of the other bytes, so the XOR of all bytes is 0.
        has_valid_crc = compute_xor(received) == 0
        if not begins_like_reply or not has_valid_crc:
            return ""
        if len(received) != pending.kind.length:
            return f"it has a valid CRC, but {len(received)} bytes instead of {pending.kind.length}"
        return str(find_error(received, pending))
