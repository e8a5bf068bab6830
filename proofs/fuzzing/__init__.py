"""Hostile input for every door of the command line: it has to stay polite, quick and small.

Owns what is tried and how a run is judged; runs in processes of its own.  In reading order:
`case`, `hostile`, `seeds`, `recipes`, `descriptions`, `terrains`, `mapfiles`, `commands`, `kinds`,
`attacks`, `worker`, `runner`, `judge`, `shrink`, `campaign`, `page`.
"""
