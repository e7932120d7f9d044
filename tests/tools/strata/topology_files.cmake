# SPDX-License-Identifier: Apache-2.0
# Landmarks given by their times on the command line; another program opens what comes out.
#   cmake -DPROGRAM=strata -DSCENARIO=F -DPYTHON=python3 -DSCRIPT=read_topology.py -DOUT=DIR -P F
include("${CMAKE_CURRENT_LIST_DIR}/run.cmake")

file(REMOVE_RECURSE "${OUT}")
run("${PROGRAM}" simulate "${SCENARIO}" --per-day --seed 3 --out "${OUT}/world" --quiet)
file(WRITE "${OUT}/times.txt" "5.0\n12.5\n20.0\n30.0\n38.5\n46.0\n")
run("${PROGRAM}" topology "${OUT}/world/day_1/log.clf" --landmarks "${OUT}/times.txt" --quiet
    --out "${OUT}/topology")
run("${PYTHON}" "${SCRIPT}" "${OUT}/topology" "${OUT}/times.txt")
