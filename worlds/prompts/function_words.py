"""Words that bind others and say nothing of a world by themselves: articles, pronouns, prepositions, conjunctions, auxiliaries.

Written and reviewed by hand, without numbers, negations and words of order (`held_lists.py`; a test keeps them apart). The lists of
Arabic and Hindi serve only to tell those languages.
"""

from __future__ import annotations

__all__ = ["FUNCTION_WORDS"]


def _listed(words: str) -> frozenset[str]:
    return frozenset(words.split())


FUNCTION_WORDS: dict[str, frozenset[str]] = {
    "en": _listed("""
        a an the this that these those it its he she they them him her his hers their theirs we us our you your i me my mine
        itself himself herself themselves who whom whose which what where why how there here
        and or but so because if though although whereas than as like
        of to in on at by for from with into onto out off over under through across along down up around about between among
        against toward towards behind beside beneath above below inside outside near upon within
        is are was were be been being am has have had having do does did will would shall should can could may might must let lets
        's 're 've 'll 'd 'm ought get gets got
        some any each every all both another other others such same own just only very too also even still yet quite rather
        please thanks show me someone somebody something anything everything"""),
    "de": _listed("""
        der die das den dem des ein eine einen einem einer eines dieser diese dieses diesem diesen jener jene jenes jeder jede jedes
        ich du er sie es wir ihr mich mir dich dir ihn ihm uns euch ihnen sich man mein meine meinen dein deine sein seine seinen seiner
        seinem ihre ihren ihrer ihrem unser unsere wer was wie wo warum wohin woher welche welcher welches
        und oder aber denn weil wenn ob dass daß sodass damit obwohl als sondern doch
        in im ins an am ans auf aus bei beim mit nach von vom vor zu zum zur über unter durch durchs für gegen um zwischen hinter neben
        hinauf hinunter herunter hinab herab hinein heraus
        ist sind war waren wird werden wurde wurden sei bin bist hat haben hatte hatten kann können könnte könntest soll sollen sollte
        muss müssen darf dürfen mag möchte möchten lass lasse lassen
        auch nur noch schon sehr so ganz mal bitte danke etwas jemand alle alles beide da dort hier dabei davon darauf darin daneben"""),
    "fr": _listed("""
        le la les l' un une des du de d' au aux ce cet cette ces c' mon ma mes ton ta tes son sa ses notre nos votre vos leur leurs
        je j' tu il elle on nous vous ils elles me m' te t' se s' lui eux y en qui que qu' quoi dont où lequel laquelle
        et ou mais car si parce puisque comme lorsqu' lorsque quand donc alors
        à dans par pour sur sous vers avec chez contre entre depuis pendant derrière devant dessus dessous hors jusqu' jusque
        est sont était étaient être été suis es sommes êtes soit ai as a ont avait avaient avoir eu fait faire fais va vont peut peux
        peuvent doit dois doivent veux voudrais
        aussi très bien plus moins tout toute tous toutes même mêmes quelque quelques chaque autre autres cela ça ici là voilà
        s'il plaît merci quelqu'un"""),
    "es": _listed("""
        el la los las lo un una unos unas del al de este esta estos estas ese esa esos esas aquel aquella mi mis tu tus su sus nuestro
        nuestra yo tú él ella nosotros ellos ellas me te se le les nos os que quien cuyo cual cuales qué quién cómo dónde cuál cuáles
        y e o u pero porque si aunque como cuando pues sino
        a en con por para sobre entre hacia desde contra bajo según durante
        es son era eran ser sea sean está están estaba estar ha han había haber hay fue fueron hace puede pueden debe deben quiero
        quisiera va van
        también muy más menos todo toda todos todas cada otro otra otros otras mismo misma así aquí ahí allí solo sólo algo alguien
        donde dentro fuera encima debajo porfa favor"""),
    "it": _listed("""
        il lo la i gli le l' un uno una un' del dello della dei degli delle dell' al allo alla ai agli alle all' dal dallo dalla dai dagli
        dalle dall' nel nello nella nei negli nelle nell' sul sullo sulla sui sugli sulle sull' col coi questo questa questi queste quest'
        quello quella quelli quelle quel quell' mio mia miei mie tuo tua suo sua suoi sue nostro nostra loro
        io tu lui lei noi voi essi mi ti si ci vi ne che chi cui quale quali come dove perché cosa cos' com' dov'
        e ed o oppure ma se anche quando mentr' però
        di a da in con su per tra fra verso contro sotto sopra dentro fuori
        è sono era erano essere sia siano ha hanno aveva avere viene vengono fa fanno può possono deve devono vorrei
        più molto tutto tutta tutti tutte ogni altro altra altri altre stesso stessa qui lì là solo qualcuno qualcosa d' c' grazie"""),
    "pt": _listed("""
        o a os as um uma uns umas do da dos das de no na nos nas ao à aos às pelo pela pelos pelas num numa dum duma este esta estes estas
        esse essa esses essas aquele aquela aqueles aquelas isto isso aquilo meu minha meus minhas teu tua seu sua seus suas nosso nossa
        eu tu ele ela nós você vocês eles elas me te se lhe lhes que quem cujo qual quais onde como porque porquê d'
        e ou mas se embora quando pois
        em com por para sobre entre até desde contra sob atrás
        é são era eram ser seja está estão estava estar tem têm tinha ter há foi foram faz vai vão pode podem deve devem quero queria
        também muito mais menos todo toda todos todas cada outro outra outros outras mesmo mesma aqui ali lá só algo alguém favor pra"""),
    "nl": _listed("""
        de het een 't dit dat deze die mijn m'n jouw je zijn z'n haar ons onze hun ik jij u hij zij ze wij we jullie mij me jou hem hen
        zich elkaar wie wat waar waarom hoe welke er daar hier
        en of maar want omdat als hoewel zodat dus
        in op aan uit bij met van voor naar door over onder om tussen achter naast tegen tot langs boven binnen buiten af
        is was waren wordt worden werd werden ben bent heeft hebben had hebt kan kun kunnen kunt moet moeten mag mogen wil zal zou zullen
        laat laten gaat
        ook nog al heel erg zeer te alle alles elk elke ieder iedere ander andere anderen zelf dezelfde hetzelfde iets iemand
        zo graag alsjeblieft alstublieft"""),
    "ru": _listed("""
        и а но или что чтобы как если когда который которая которое которые которого которой которую которых которым где куда откуда
        почему зачем кто чего чем кого кому
        в во на с со к ко у о об от из изо за под над по при для про через между около вокруг вдоль мимо сквозь против
        я ты он она оно мы вы они меня тебя его её ее нас вас их мне тебе ему ей нам вам им мной ним ней них него неё себя себе собой
        мой моя моё мои твой свой своя своё свои наш ваш этот эта это эти этого этой этому этим тот та то те того той тому тем
        весь вся всё все всех
        был была было были есть будет будут быть бы ли же уже ещё еще так там тут здесь тоже также очень только лишь даже вот ну
        пусть пожалуйста можно нужно надо хочу какой какая какие"""),
    "zh": _listed("的 了 着 在 是 和 与 把 被 从 到 向 往 对 给 让 用 以 之 而 也 都 就 很 这 那 你 我 他 她 它 们 个 里 上 下 中 会 能 要"),
    "ja": _listed("の は が を に で と も へ や か から まで です ます する して した いる ある この その あの これ それ よう こと"),
    "ar": _listed("""
        في من على إلى الى عن مع هذا هذه ذلك تلك التي الذي الذين أن إن ما لا هو هي ثم حتى بين تحت فوق عند بعد قبل كل بلا دون أو و كي
        لكن ينبغي يجب كان كانت وهو وهي فيها فيه منها عليه عليها بينما عندما حين نحو داخل خارج"""),
    "hi": _listed("""
        है हैं में की के का को से पर और यह वह ये वे जो कि ने तो भी हो हुआ हुई हुए रहा रही रहे था थी थे एक इस उस अपने अपनी अपना कर लिए तक
        जब फिर या मगर लेकिन होता होती होते जाता जाती जाते गया गई गए"""),
}  # fmt: skip
