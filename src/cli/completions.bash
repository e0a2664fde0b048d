# Bash splits words at = and :, but stickslip does not, so the parts are joined as they are in the line.
_stickslip() {
    local line=${COMP_LINE:0:COMP_POINT} words=() word blank k
    for ((k = 0; k <= COMP_CWORD; k++)); do
        blank=${line%%[![:space:]]*}
        line=${line:${#blank}}
        word=$line
        if ((k < COMP_CWORD)); then
            word=${COMP_WORDS[k]}
            line=${line#"$word"}
        fi
        if [[ -z $blank && ${#words[@]} -gt 0 ]]; then
            words[${#words[@]} - 1]+=$word
        else
            words+=("$word")
        fi
    done
    # For a word that bash splits, it expects only the part after the last split.
    local present=${words[${#words[@]} - 1]} breaks=${COMP_WORDBREAKS//[!=:]/} before=""
    if [[ -n $breaks ]]; then
        before=${present%"${present##*[$breaks]}"}
    fi
    COMPREPLY=()
    while IFS= read -r word || [[ -n $word ]]; do
        word=${word#"$before"}
        if [[ $word == *[[:space:]]* ]]; then
            printf -v word %q "$word"
        fi
        COMPREPLY+=("$word")
    done < <(STICKSLIP_COMPLETE=bash _CLAP_IFS=$'\n' _CLAP_COMPLETE_INDEX=$((${#words[@]} - 1)) \
        "$1" -- "${words[@]}" 2>/dev/null)
    # A path of a setting is followed by its value, a folder by its content.
    if [[ ${#COMPREPLY[@]} -eq 1 && ${COMPREPLY[0]} == *[=/] ]]; then
        compopt -o nospace 2>/dev/null
    fi
}
complete -o bashdefault -o default -F _stickslip stickslip
