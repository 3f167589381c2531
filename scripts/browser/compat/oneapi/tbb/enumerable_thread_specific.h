#include "tbb/serial.hpp"
