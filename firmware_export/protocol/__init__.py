"""The protocol of codecs, for those who choose, certify and write exports.

In reading order: `policy`, `codec`, `blob`.
"""

from firmware_export.protocol.blob import VERSION, Blob, describe, restored, stored, turns
from firmware_export.protocol.codec import CArray, CBody, Channels, Codec, Export, Tables, literal
from firmware_export.protocol.policy import CONTROL_VERSION, Joint, Policy
