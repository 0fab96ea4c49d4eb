// All tests of the page: one bake, one daemon and one browser for them all.

import './load.js';
import './move.js';
import './look.js';
import './places.js';
import './planets.js';
import './away.js';
