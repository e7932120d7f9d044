# Runs fastddsgen over all IDLs at once: cmake -DFASTDDSGEN=… -DIDLS=a.idl;b.idl -DOUT=dir -P this
# Preprocessed files go to a folder of our own: in /tmp, the default, two builds at once would write
# over each other's.
# What is the same as before keeps its date, so that a new type has only its users compiled anew.
set(fresh ${OUT}/fresh)
file(REMOVE_RECURSE ${fresh})
file(MAKE_DIRECTORY ${fresh} ${OUT}/preprocessed)
list(GET IDLS 0 first)
get_filename_component(folder ${first} DIRECTORY)
# -cs: names are case-sensitive (else member `pose` meets type `Pose`); -typeros2: ROS 2's type names.
execute_process(
  COMMAND ${FASTDDSGEN} -replace -cs -typeros2 -I ${folder} -t ${OUT}/preprocessed -d ${fresh} ${IDLS}
  OUTPUT_VARIABLE output ERROR_VARIABLE output RESULT_VARIABLE result)
# A syntax error is only printed; the exit code stays 0.
if(result OR output MATCHES "error:")
  message(FATAL_ERROR "fastddsgen failed:\n${output}")
endif()
# The generator names a Fast DDS header for bounded strings, of which we have none; without the line
# the types need Fast CDR only.
foreach(idl ${IDLS})
  get_filename_component(package ${idl} NAME_WE)
  file(READ ${fresh}/${package}.h text)
  string(REGEX REPLACE "#include <fastrtps/utils/fixed_size_string.hpp>\n" "" text "${text}")
  file(WRITE ${fresh}/${package}.h "${text}")
endforeach()
file(GLOB made ${fresh}/*)
foreach(file ${made})
  get_filename_component(name ${file} NAME)
  execute_process(COMMAND ${CMAKE_COMMAND} -E copy_if_different ${file} ${OUT}/${name})
endforeach()
file(REMOVE_RECURSE ${fresh})
