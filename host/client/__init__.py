"""A robot as a program sees it: the conversation on a link, and the verbs for people."""
