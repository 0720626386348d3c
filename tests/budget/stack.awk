# SPDX-License-Identifier: MIT
# awk -v kernels="NAMES" -f stack.awk FILE.su... SYMBOLS DISASSEMBLY: the deepest stack of a linked program (objdump -t and
# -d), and the calls that lead there. Frames are those that gcc -fstack-usage states, and what functions push where it says
# nothing (libgcc, assembly). Calls through pointers may reach every kernel, but for the one that hands out triangles; the
# application's own are left out.
FILENAME ~ /\.su$/ {
    count = split($1, part, "[:/]")
    at = part[count - 3] ":" part[count]
    if ($2 > frame[at]) frame[at] = $2
    next
}
$3 == "df" {
    file = $NF
    next
}
/ F \.text/ {
    address = $1
    sub(/^0+/, "", address)
    title[address] = $NF
    own_frame[address] = frame[file ":" $NF]
    if ($2 == "g")
        for (at in frame)
            if (substr(at, index(at, ":") + 1) == $NF) own_frame[address] = frame[at]
    if (index(" " kernels " draw_triangle ", " " $NF " ")) target[$NF] = address
    next
}
/^[0-9a-f]+ <.*>:$/ {
    name = $1
    sub(/^0+/, "", name)
    all[name] = 1
    next
}
name && $2 ~ /^push/ {
    list = $0
    sub(/.*\{/, "", list)
    sub(/\}.*/, "", list)
    pushed[name] += 4 * registers(list)
}
name && $2 ~ /^sub/ && $3 == "sp," {
    bytes = $NF
    sub(/#/, "", bytes)
    pushed[name] += bytes
}
name && $2 ~ /^(bl|b|b\.n|b\.w)$/ && /<[^+>]*>/ {
    to = $3
    if (to != name) call(name, to, $2 == "bl")
}
name && $2 == "blx" {
    if (title[name] ~ /^soft_each_triangle/) call(name, target["draw_triangle"], 1)
    else if (title[name] !~ /^nacre_soft_bands/) through[name] = 1
}
function registers(list, count, n, i, range, ends) {
    n = split(list, range, ", *")
    for (i = 1; i <= n; i++) {
        if (split(range[i], ends, "-") == 2) {
            sub(/r/, "", ends[1])
            sub(/r/, "", ends[2])
            count += ends[2] - ends[1]
        }
        count++
    }
    return count
}
function call(from, to, deeper) {
    calls[from] = calls[from] " " to (deeper ? "" : "!")
}
# Bytes below the caller's frame when `name` runs; best[name]: the callee that needs most.
function depth(name, list, n, i, to, own, tail, here, most, step) {
    if (name in done) return done[name]
    done[name] = 0
    own = own_frame[name] + 0 > pushed[name] + 0 ? own_frame[name] : pushed[name] + 0
    most = own
    n = split(calls[name] (name in through ? reached : ""), list, " ")
    for (i = 1; i <= n; i++) {
        to = list[i]
        tail = sub(/!$/, "", to)
        if (!(to in all)) continue
        here = depth(to) + (tail ? 0 : own)
        if (here > most) {
            most = here
            best[name] = to
        }
    }
    return done[name] = most
}
END {
    for (name in target) if (name != "draw_triangle") reached = reached " " target[name]
    for (name in all) if (title[name] ~ /^nacre_/ && depth(name) > most) {
        most = depth(name)
        deepest = name
    }
    text = title[deepest]
    for (name = deepest; name in best; name = best[name]) text = text " > " title[best[name]]
    print most, text
}
