# SPDX-License-Identifier: Apache-2.0
# Simulates SCENARIO, learns from all days but the last, compares the models on the last one, and
# lets an independent script recompute the result.
#   cmake -DPROGRAM=strata -DSCENARIO=F -DDAYS=n -DSEED=n -DSCRIPT=recompute_comparison.py -DOUT=DIR -P F
include("${CMAKE_CURRENT_LIST_DIR}/run.cmake")

file(REMOVE_RECURSE "${OUT}")
run("${PROGRAM}" simulate "${SCENARIO}" --per-day --seed ${SEED} --out "${OUT}/world" --quiet)
math(EXPR before "${DAYS} - 1")
foreach(day RANGE 1 ${DAYS})
  list(APPEND poses "${OUT}/world/day_${day}/truth.tum")
endforeach()
foreach(day RANGE 1 ${before})
  list(APPEND train "${OUT}/world/day_${day}/log.clf")
endforeach()
run("${PROGRAM}" compare --train ${train} --test "${OUT}/world/day_${DAYS}/log.clf" --poses ${poses}
    --models occupancy,patch,patch_paper,timescale --seeds 9 --quiet
    --set localizer.kld.max_particles=400 --out "${OUT}/result")
find_package(Python3 REQUIRED COMPONENTS Interpreter)
run("${Python3_EXECUTABLE}" "${SCRIPT}" "${OUT}/result")
