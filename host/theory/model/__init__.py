"""The analytic model: the equations of a wheel in numbers and in symbols."""
