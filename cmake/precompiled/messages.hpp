// SPDX-License-Identifier: Apache-2.0
/// What most files of components and tools read.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <mutex>
#include <sstream>
#include <thread>

#include "cmake/precompiled/core.hpp"
#include "strata_idl/bond.h"
#include "strata_idl/diagnostic_msgs.h"
#include "strata_idl/geometry_msgs.h"
#include "strata_idl/lifecycle_msgs.h"
#include "strata_idl/nav2_msgs.h"
#include "strata_idl/nav_msgs.h"
#include "strata_idl/octomap_msgs.h"
#include "strata_idl/rcl_interfaces.h"
#include "strata_idl/rosgraph_msgs.h"
#include "strata_idl/sensor_msgs.h"
#include "strata_idl/std_srvs.h"
#include "strata_idl/strata_msgs.h"
#include "strata_idl/tf2_msgs.h"
#include "strata_idl/type_description_interfaces.h"
