message(FATAL_ERROR "npm could not get the packages of tools/chart. Without a network, configure with -DWEIR_CHART=OFF: "
                    "everything but the page of weir chart is then built.")
