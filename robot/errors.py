"""The one way in which the robot says no."""

# In characters. JSON may need twelve bytes for each, so that a refusal fits into a frame even if
# what it refuses is long. A hint is the robot's own words, with next to nothing of what it refuses.
LONGEST_MESSAGE = 200
LONGEST_HINT = 200


class Refused(Exception):
    """A request that was not carried out and changed nothing.

    Args:
        code: For programs: one of the codes in PROTOCOL.md.
        message: What was refused, and why.
        hint: What to do.
    """

    def __init__(self, code, message, hint=""):
        Exception.__init__(self, message)
        self.code = code
        self.message = message[:LONGEST_MESSAGE]
        self.hint = hint[:LONGEST_HINT]

    def as_dict(self):
        """The refusal as it goes over the wire."""
        return {"code": self.code, "message": self.message, "hint": self.hint}
