"""The guided exercises of the lab: their texts, and checks of what a pupil has done."""
