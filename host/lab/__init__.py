"""The lab page: a person watches a running robot in a browser, kicks it and changes it."""
