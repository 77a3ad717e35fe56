"""Where signals come from, by the carrier phases of three antennas or more on a moving vehicle.

:mod:`.geometry` has the array, :mod:`.phases` what it measures, :mod:`.directions` what that says
of the source. Tests: :mod:`.motion`, whether the source stands still as a satellite does;
:mod:`.arrival`, whether it stands where the satellite should; :mod:`.between`, whether two signals
have one source.
"""
