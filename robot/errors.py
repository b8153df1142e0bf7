"""The one way in which the robot says no."""

# Characters, of which JSON may need twelve bytes each: what is refused may be long, its refusal
# fits into a frame
LONGEST_MESSAGE = 200


class Refused(Exception):
    """A request that was not carried out and changed nothing.

    `code` is for programs, `message` says what and why, `hint` what to do.
    """

    def __init__(self, code, message, hint=""):
        Exception.__init__(self, message)
        self.code = code
        self.message = message[:LONGEST_MESSAGE]
        self.hint = hint

    def as_dict(self):
        """The refusal as it goes over the wire."""
        return {"code": self.code, "message": self.message, "hint": self.hint}
