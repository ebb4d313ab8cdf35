"""The known shapes of text logs, as data: how each is recognised, and what its columns mean.

Each TOML file beside this module has a list ``shape``. A shape has ``name``, ``source`` (where its facts come from), and of these keys
those that it needs:

* ``header``: ends of names that the header must have. Names are compared in lower case, without their unit, and with a point for
  each run of blanks, slashes, colons, points and square brackets: ``/imu/angular_velocity/x`` ends in ``angular_velocity.x``.
  ``absent``: ends of names that it must not have;
* ``file``: pattern of the file's name; ``text``: pattern of the file's first bytes;
* ``cells`` and ``ranges``: number of cells, and {cell: [least, greatest]}, of the rows of a file without a header; ``steps``:
  least and greatest median step of its time, s; ``changes``: {cell: greatest change from row to row}; ``row``: the meaning of each
  cell, ``-`` for none;
* ``columns``: {end of a name: meaning}; three letters or digits in braces stand for x, y and z: ``"gyro_{xyz}"``;
* ``refused``: {end of a name: why the column is not used};
* ``frame``: directions of x, y and z, such as ``FLU``, ``FRD`` or ``RFU``; of two frames, the first holds if z of the specific force is
  positive in the first rows. Without it, the axes are those of the sensor, and taken as FRD;
* ``epoch``: start of its time; ``rate``: pattern in the first bytes whose group is the sampling rate, Hz;
* ``sparse``: true if a row has the cells of some topics alone; ``remark``: a sentence for the user.

A meaning is a quantity and the unit that the format fixes: ``gyro rad/s``; a minus before it changes the sign. A unit that
the file itself states is used in place of it; without a unit, the user is asked.
"""
