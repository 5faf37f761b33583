"""Extensions of the protocol that the server offers: tasks and skills.

Nothing is imported here: worker processes use `inputs` and need no protocol for that.
"""
